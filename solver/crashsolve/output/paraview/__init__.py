"""What viewers open the states by: the index in XDMF, and a script for ParaView."""
