"""HTML pages: the report of a result, and that of a check."""
