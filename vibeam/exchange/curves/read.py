"""Reading of the columns of a measured file, by its ending: the name under which other programs import it."""

from vibeam.exchange.curves.columns import is_text as is_text
from vibeam.exchange.curves.columns import read_columns as read_columns
