"""Statements of a campaign that its recordings contradict before anything is fitted.

Each hypothesis is one file: how it changes the campaign, and its message. All are judged by the first motion of the body and
the wheels after the release, and by one fit each only where several remain.
"""
