"""`python -m tyrefrf` is `tyrefrf`."""

from tyrefrf.cli.main import main

if __name__ == "__main__":
    main()
