"""`python -m cleancli` is the command `cleancli`."""

from cleancli.cli.main import main

if __name__ == "__main__":
    main()
