"""What a reduction loses, known beforehand."""
