function robot = SerialLink(links, varargin)
% stand-in
robot = struct('name', varargin{2}, 'gravity', [0; 0; 9.81], 'base', eye(4), 'tool', eye(4));
robot.links = links;
end
