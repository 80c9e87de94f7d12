"""Sections, cells and the places on them."""
