"""Pictures of maps: one module a picture, each of the quantities alone."""
