"""`python -m contwalk`."""

from contwalk.cli import main

if __name__ == "__main__":
    main()
