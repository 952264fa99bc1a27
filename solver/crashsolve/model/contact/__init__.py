"""Tables of contact, made once: elements and pairs of surfaces; neither laws nor the step."""
