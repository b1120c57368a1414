"""Files of other programs: a URDF, an xacro or an MJCF as links and joints, in exact decimals."""
