"""Check shapes, dtypes and types at every call, as `make test` does; an int is a float too."""

from beartype import BeartypeConf, beartype

check = beartype(conf=BeartypeConf(is_pep484_tower=True))
