function T = pose_of(robot, q)
% pose of the stand-ins: SerialLink (a structure) or rigidBodyTree (an object)
if isstruct(robot)
  T = robot.base;
  for k = 1:numel(robot.links)
    T = T * link_pose(robot.links(k), q(k));
  end
  T = T * robot.tool;
  return
end
T = eye(4);
k = 0;
for i = 1:numel(robot.Bodies)
  joint = robot.Bodies{i}.Joint;
  motion = eye(4);
  if ~strcmp(joint.Type, 'fixed')
    k = k + 1;
    if strcmp(joint.Type, 'revolute')
      motion = [cos(q(k)), -joint.JointAxis(3) * sin(q(k)), 0, 0; joint.JointAxis(3) * sin(q(k)), cos(q(k)), 0, 0; 0, 0, 1, 0; 0, 0, 0, 1];
    else
      motion(3, 4) = joint.JointAxis(3) * q(k);
    end
  end
  T = T * joint.JointToParentTransform * motion * joint.ChildToJointTransform;
end
end

function T = link_pose(link, q)
if link.flip
  q = -q;
end
q = q + link.offset;
if link.sigma == 0
  theta = q; d = link.d;
else
  theta = link.theta; d = q;
end
Z = [cos(theta), -sin(theta), 0, 0; sin(theta), cos(theta), 0, 0; 0, 0, 1, d; 0, 0, 0, 1];
X = [1, 0, 0, link.a; 0, cos(link.alpha), -sin(link.alpha), 0; 0, sin(link.alpha), cos(link.alpha), 0; 0, 0, 0, 1];
if link.mdh
  T = X * Z;
else
  T = Z * X;
end
end
