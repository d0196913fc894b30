"""Lets ``python -m sprung`` do what ``sprung`` does."""

from sprung.cli import main

main()
