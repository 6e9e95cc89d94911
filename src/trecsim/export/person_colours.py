"""One colour per person, the same as on the live page and in the reports."""

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#332288", "#882255")


def colour(person: int) -> str:
    """Return the colour of a person.

    Examples
    --------
    >>> colour(0), colour(8)
    ('#0072b2', '#0072b2')
    """
    return COLOURS[person % len(COLOURS)]


def rgb(person: int) -> tuple[float, float, float]:
    """Return the colour of a person as red, green and blue from 0 to 1."""
    text = colour(person)
    red, green, blue = (round(int(text[at : at + 2], 16) / 255, 4) for at in (1, 3, 5))
    return red, green, blue
