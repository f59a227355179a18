"""`python -m benchnav`: the command line, without the script `benchnav` on the search path."""

from benchnav.cli.main import main

if __name__ == "__main__":  # worker processes may import this module again
    main()
