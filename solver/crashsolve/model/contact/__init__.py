"""Build of contact: surfaces to elements, elements to pairs and projections."""
