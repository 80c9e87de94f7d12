"""`python -m tyrefrf` is `tyrefrf`."""

from tyrefrf.cli.start import command

if __name__ == "__main__":
    command()
