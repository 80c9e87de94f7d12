"""`python -m tyrefrf` is `tyrefrf`."""

from tyrefrf.cli.main import command

if __name__ == "__main__":
    command()
