classdef rigidBody < handle
  % stand-in
  properties
    Name = '';
    Joint = [];
    Mass = 1;
    CenterOfMass = [0, 0, 0];
    Inertia = [1, 1, 1, 0, 0, 0];
  end
  methods
    function body = rigidBody(name)
      body.Name = name;
    end
  end
end
