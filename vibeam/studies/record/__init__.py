"""Studies of cases under a record: each flies variants of a case through the same realisations."""
