"""Uncertain rigs: plain samples of them, their exact peaks by closed forms of many at once, intervals beside both."""
