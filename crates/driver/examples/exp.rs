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
 let refb=std::fs::read_to_string("../shared/cases/B_mesh20_g2_mu0.1_exact_load.csv").unwrap();
 let refl:Vec<f64>=refb.lines().skip(1).map(|l|l.split(',').nth(2).unwrap().parse().unwrap()).collect();
 for name in ["ssn","gs","uzawa","pen"] {
  let mut st=Settings::default();
  match name {"gs"=>st.contact=Box::new(GaussSeidel::default()),"uzawa"=>st.contact=Box::new(Uzawa::default()),"pen"=>st.contact=Box::new(Penalty::new(1e8,1e8).unwrap()),_=>{}}
  let mut d=b(10,2,0.1,Integration::Reduced,st);
  let step=Step::new("press").fix("block.left",&[Axis::X]).displace("punch",Axis::Y,-0.2);
  let t=std::time::Instant::now();
  let r=d.run(&step,20,|d,r|{ if name=="ssn"||r.increment==20 {
   let p=-d.reaction("punch").unwrap()[1];
   println!("{name} {} P={p:.6} rel={:.1e} newton {} contact {} fact {} cut {} short {} o/s/s {}/{}/{} gap {:.1e} pen {:.1e} oob {:.1e} imb {:.2e} W {:.4}",r.increment,p/refl[r.increment-1]-1.0,r.newton_iterations,r.contact_iterations,r.factorisations,r.cuts,r.shortened_steps,r.open,r.stick,r.slip,r.relative_gap(),r.certificate.penetration,r.out_of_balance,r.energies.imbalance(),r.energies.external_work);
   if name=="ssn" && r.increment>10 && r.increment<14 {println!("{:?}",r.residuals);} } });
  println!("{name} time {:?} newton {:?} {}",t.elapsed(), r.as_ref().map(|r|r.iter().map(|r|r.newton_iterations).sum::<usize>()), r.as_ref().err().map(|e|e.to_string()).unwrap_or_default());
 }
}
