"""Plastic hinges: joints whose free motions an elastic-plastic moment or force resists."""
