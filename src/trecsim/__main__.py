"""``python -m trecsim`` is the command ``trecsim``."""

from trecsim.cli import main

main()
