"""Structured fuzz: hostile texts and bytes, made by grammars that know what they attack."""
