"""Extensions that come with vibeam: each is found by its entry point, and none of the packages beside imports one."""
