"""Kinds of files by the extensions of their names."""

from __future__ import annotations

NO_RECORDINGS = frozenset(
    (".toml", ".json", ".npz", ".html", ".htm", ".py", ".md", ".pdf", ".png", ".jpg", ".jpeg", ".svg", ".doc", ".docx", ".ppt",
     ".pptx", ".zip", ".mp4", ".mov", ".ini", ".log", ".db",
     ".bak", ".orig", ".tmp", ".toml~",
     ".m", ".mlx", ".slx", ".slxc", ".mdl", ".vi")
)  # fmt: skip
"""Extensions, in lower case, of files in a folder of recordings that are none."""
