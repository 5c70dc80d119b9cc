"""What the scripts that make tables and figures share: their command line."""

import sys


def arguments(documentation, least):
    """The command line's arguments. Prints the script's documentation and ends when that is asked for (status 0), or when
    there are fewer arguments than `least` (2)."""
    given = sys.argv[1:]
    if {"-h", "--help"} & set(given):
        print(documentation.strip())
        sys.exit(0)
    if len(given) < least:
        print(documentation.strip(), file=sys.stderr)
        sys.exit(2)
    return given
