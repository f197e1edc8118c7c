"""What today's executives do with the same work, in their own idiom. Each module is imported only if it is there."""
