classdef rigidBodyTree < handle
  % stand-in: a chain of bodies
  properties
    Bodies = {};
    Gravity = [0, 0, 0];
  end
  methods
    function tree = rigidBodyTree(varargin)
    end
    function addBody(tree, body, parent)
      if isempty(tree.Bodies)
        last = 'base';
      else
        last = tree.Bodies{end}.Name;
      end
      if ~strcmp(last, parent)
        error('%s hangs on %s, not on %s', body.Name, parent, last);
      end
      tree.Bodies{end + 1} = body;
    end
  end
end
