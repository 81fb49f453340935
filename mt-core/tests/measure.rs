//! tmp
use mt_core::format::*; use mt_core::Mesh; use glam::Vec3; use std::time::Instant;
fn status(key:&str)->usize{ std::fs::read_to_string("/proc/self/status").unwrap().lines().find(|l|l.starts_with(key)).unwrap().split_whitespace().nth(1).unwrap().parse::<usize>().unwrap()/1024}
#[test] fn measure(){
 let n=1000usize;
 let mut p=vec![]; for i in 0..n{for j in 0..n{p.push(Vec3::new(i as f32*0.001234567, j as f32*0.0012345, ((i*7919+j*104729)%1000) as f32*1e-5));}}
 let mut c=vec![]; for i in 0..n as u32-1{for j in 0..n as u32-1{let a=i*n as u32+j; c.push([a,a+1,a+n as u32]); c.push([a+1,a+n as u32+1,a+n as u32]);}}
 let mesh=Mesh::from_indices(p,&c); drop(c);
 let only=std::env::var("ONLY").unwrap_or("ply".into());
 let format=Format::from_extension(&only).unwrap();
 let t=Instant::now(); let bytes=write(format,&mesh).unwrap(); println!("{format} write {:?} {} MB",t.elapsed(),bytes.len()>>20); drop(mesh);
 std::fs::write("/proc/self/clear_refs","5").ok();
 let before=status("VmRSS");
 for _ in 0..2 { let t=Instant::now(); let (m,r)=read(format,&bytes,&LoadOptions::default(),&|_|None).unwrap(); println!("{format} read {:?} rss {before} peak {}",t.elapsed(),status("VmHWM"));
 let t=Instant::now(); let c=census(&m); println!("   census {:?} {}",t.elapsed(), c==r.census);
 let t=Instant::now(); let mut m=m; split_non_manifold(&mut m); println!("   split {:?}",t.elapsed());}
}
