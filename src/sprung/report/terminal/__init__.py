"""Text for the terminal: tables and lists that fit any width."""
