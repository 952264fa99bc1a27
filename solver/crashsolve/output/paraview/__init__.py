"""Files with which viewers open the states: the index in XDMF, and a script for ParaView."""
