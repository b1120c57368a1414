classdef rigidBodyJoint < handle
  % stand-in: transforms as MathWorks documents setFixedTransform
  properties
    Name = '';
    Type = 'fixed';
    JointAxis = [0, 0, 1];
    PositionLimits = [-pi, pi];
    JointToParentTransform = eye(4);
    ChildToJointTransform = eye(4);
  end
  methods
    function joint = rigidBodyJoint(name, type)
      joint.Name = name;
      joint.Type = type;
    end
    function setFixedTransform(joint, numbers, kind)
      if nargin == 2
        joint.JointToParentTransform = numbers;
        return
      end
      a = numbers(1); alpha = numbers(2); d = numbers(3); theta = numbers(4);
      if strcmp(joint.Type, 'revolute')
        theta = 0;  % documented: ignored
      else
        d = 0;
      end
      Z = [cos(theta), -sin(theta), 0, 0; sin(theta), cos(theta), 0, 0; 0, 0, 1, d; 0, 0, 0, 1];
      X = [1, 0, 0, a; 0, cos(alpha), -sin(alpha), 0; 0, sin(alpha), cos(alpha), 0; 0, 0, 0, 1];
      if strcmp(kind, 'dh')
        joint.ChildToJointTransform = Z * X;
      else
        joint.JointToParentTransform = X * Z;
      end
    end
  end
end
