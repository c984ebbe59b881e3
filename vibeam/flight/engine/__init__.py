"""The engine as Python calls it: entry points, the libraries behind them, threads."""
