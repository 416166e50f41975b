// A plate with a round notch, six-node triangles that are fine at the notch:
// gmsh -2 -order 2 plate.geo -o plate.msh
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 50, 20};
Disk(2) = {20, 20, 0, 3};
BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; };
Physical Surface("block") = {3};
Physical Curve("all") = Boundary{ Surface{3}; };
Field[1] = MathEval;
Field[1].F = "0.02+0.02*Sqrt((x-20)^2+(y-17)^2)";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
