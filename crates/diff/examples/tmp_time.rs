use hwasp_diff::{Activation, Mlp};
use std::time::Instant;
fn main(){
  for (sizes, rows) in [(vec![2usize,32,32,1],128usize),(vec![2,32,32,1],256),(vec![2,32,32,1],64),(vec![11,128,128,4],128),(vec![11,128,128,4],256)] {
    let mlp=Mlp::new(&sizes,Activation::Tanh,Activation::Tanh);
    let mut s=1u64; let p=mlp.init(1.0,||{s^=s<<13;s^=s>>7;s^=s<<17;(s>>11) as f64/(1u64<<53) as f64});
    let x:Vec<f32>=(0..rows*sizes[0]).map(|i|((i*37%101) as f32)/50.-1.).collect();
    let c:Vec<f32>=vec![0.3;rows*mlp.outputs()];
    let mut t=mlp.tape(rows); let mut g=vec![0f32;p.len()];
    let time=|f:&mut dyn FnMut()|{ let n=2000; let mut best=1e9f64; for _ in 0..10{ let t=Instant::now(); for _ in 0..n{f();} best=best.min(t.elapsed().as_secs_f64()/n as f64*1e6);} best};
    mlp.bind(&p,&mut t);
    let b=time(&mut ||mlp.bind(&p,&mut t));
    let f=time(&mut ||mlp.forward(&x,rows,&mut t));
    let v=time(&mut ||{mlp.vjp(&x,&c,&mut t)});
    let gr=time(&mut ||{mlp.gradient(&t,&mut g)});
    let f1=time(&mut ||mlp.forward(&x[..sizes[0]],1,&mut t));
    let f32_=time(&mut ||mlp.forward(&x[..sizes[0]*32],32,&mut t));
    println!("{sizes:?} rows {rows}: bind {b:.2} fwd {f:.2} vjp {v:.2} gradient {gr:.2} | one row {f1:.3} 32 rows {f32_:.2} us");
  }
}
