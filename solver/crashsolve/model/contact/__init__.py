"""Tables of contact, made once: elements and pairs of surfaces; nothing of a step."""
