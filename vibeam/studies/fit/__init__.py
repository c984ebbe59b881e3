"""Joint estimation of a case's keys from measured frequency responses, along branches."""
