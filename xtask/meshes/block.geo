// A block with a dent, ten-node tetrahedra that are fine below it:
// gmsh -3 -order 2 block.geo -o block.msh
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 2, 1, 1};
Sphere(2) = {1, 0.5, 1, 0.3};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("block") = {3};
Field[1] = MathEval;
Field[1].F = "0.03+0.12*Sqrt((x-1)^2+(y-0.5)^2+(z-0.7)^2)";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
