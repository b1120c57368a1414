function link = Link(varargin)
% stand-in: the fields of a link of Corke's Robotics Toolbox
link = struct('sigma', 0, 'theta', 0, 'd', 0, 'a', 0, 'alpha', 0, 'mdh', false, 'offset', 0, 'flip', false, ...
  'qlim', [], 'm', 0, 'r', [0, 0, 0], 'I', zeros(3), 'Jm', 0, 'G', 1, 'B', 0, 'Tc', [0, 0]);
k = 1;
while k <= numel(varargin)
  switch varargin{k}
    case 'revolute', link.sigma = 0;
    case 'prismatic', link.sigma = 1;
    case 'standard', link.mdh = false;
    case 'modified', link.mdh = true;
    otherwise
      k = k + 1;
      link.(varargin{k - 1}) = varargin{k};
  end
  k = k + 1;
end
end
