"""The case file, declared once: the parser, its messages, the reference table and the template all read this.

A table is a class, a key a field: its annotation says what it may hold, ``key`` what it means and what to write.
"""
