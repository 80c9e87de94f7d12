"""Elements, materials and the cell's matrices."""
