"""What each effect of a case changes and costs, and which of them the scene needs."""
