#![allow(missing_docs, clippy::print_stdout)]
use moreau_contact::*; use moreau_driver::*; use moreau_laws::*; use moreau_mesh::*;
fn b(nx:usize,ny:usize,mu:f64,int:Integration,settings:Settings<2>)->Driver<2>{
 let mut mesh = block2("block", CellKind::Quad8, &uniform(0.0, 50.0, nx), &uniform(0.0, 20.0, ny)).unwrap();
 mesh.node_group_where("punch", "block.top", |x| x[0] <= 25.0+1e-9).unwrap();
 let model = Model::new(mesh, PlaneStrain::default()).material("block", VonMises::new(210e3,0.3,300.0).unwrap(), int).unwrap()
  .tool("foundation", Plane::new([0.0,0.0],[0.0,1.0]).unwrap()).unwrap().contact("block.bottom","foundation",Coulomb::new(mu).unwrap()).unwrap();
 Driver::new(model,settings).unwrap()
}
fn main(){
 for tol in [1e-4,1e-6,1e-8] { 
  let mut st=Settings::default(); st.nesting=Nesting::Outside{tolerance:tol,iterations:20000}; st.cuts=0;
  let mut d=b(10,2,0.1,Integration::Reduced,st);
  let step=Step::new("press").fix("block.left",&[Axis::X]).displace("punch",Axis::Y,-0.05);
  let t=std::time::Instant::now();
  let r=d.run(&step,5,|d,r|{
   let p=-d.reaction("punch").unwrap()[1];
   println!("{tol:e} {} P={p:.6} solves {} newton {} fact {} o/s/s {}/{}/{} gap {:.1e} pen {:.1e} {:?}",r.increment,r.nonlinear_solves,r.newton_iterations,r.factorisations,r.open,r.stick,r.slip,r.relative_gap(),r.certificate.penetration,t.elapsed());
  });
  println!("{:?} {}",t.elapsed(), r.as_ref().err().map(|e|e.to_string()).unwrap_or_default());
 }
}
