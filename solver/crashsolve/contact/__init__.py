"""Contact between surfaces: shapes, gaps between them, and normal force laws."""
