"""A reactor that lives long: nothing of a situation stays behind when it has ended."""
