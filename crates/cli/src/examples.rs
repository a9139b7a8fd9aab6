//! Examples in the help of the commands.

/// Of `pneuflex run`.
pub const RUN: &str = "\
Examples:
  pneuflex run actuator.toml                                  results in out/actuator
  pneuflex run actuator.toml --set mesh.resolution=draft      a quick look
  pneuflex run actuator.toml --set load.pressure_kpa='[10, 20]' --out out/low
  pneuflex run actuator.toml --resume                         go on after Ctrl-C or a crash
  pneuflex run actuator.toml --estimate                       and say how exact the last state is
  pneuflex run actuator.toml --gradient end_face_angle@35     and what changes the angle at 35 kPa most

Exit codes: 0 converged or followed past a limit point, 1 an output could not be written, 2 bad input (nothing written), 3 not converged (what was reached is kept), 130 interrupted.";

/// Of `pneuflex check`.
pub const CHECK: &str = "\
Examples:
  pneuflex check actuator.toml
  pneuflex check actuator.toml --set actuator.chambers=12 --set mesh.resolution=fine
  pneuflex check finger.toml --picture finger.html            look at cavities, supports and contact before solving";

/// Of `pneuflex check-gradient`.
pub const CHECK_GRADIENT: &str = "\
Examples:
  pneuflex check-gradient finger.toml --of end_face_angle@35 --by actuator.side_wall
  pneuflex check-gradient finger.toml --of tip.z --by material.c10 --by actuator.gap

Every key takes four runs on the elements of the case, to tight tolerances.";

/// Of `pneuflex uncertainty`.
pub const UNCERTAINTY: &str = "\
Examples:
  pneuflex uncertainty finger.toml --of end_face_angle --tolerance actuator.top_wall=0.1
  pneuflex uncertainty finger.toml --of tip.z@35 --tolerance material.c10=10% --check 50

A key is anywhere within its tolerance with the same probability, independent of the others.";

/// Of `pneuflex new`.
pub const NEW: &str = "\
Examples:
  pneuflex new two-chamber                two_chamber.toml, solved within seconds
  pneuflex new actuator finger.toml       eight chambers, under another name
  pneuflex new model part.step            part.toml, around a body of your own: part from CAD, mesh or deck";

/// Of `pneuflex mesh`.
pub const MESH: &str = "\
Examples:
  pneuflex mesh part.step                 part.msh, whose elements follow the thinnest wall
  pneuflex mesh scan.stl --size 2 --out coarse.msh

It needs Gmsh, as the Python package: pip install gmsh";

/// Of `pneuflex converge`.
pub const CONVERGE: &str = "\
Examples:
  pneuflex converge two_chamber.toml --set mesh.resolution=draft
  pneuflex converge two_chamber.toml --set mesh.resolution=draft --levels 2 --out out/twice

  pneuflex converge finger.toml --levels 2        a model file: its elements divided as they are

The second mesh has 8 times the elements of the first, the third 27 times, in model files and decks 64 times.";

/// Of `pneuflex sweep`.
pub const SWEEP: &str = "\
Examples:
  pneuflex sweep gaps.toml                        a table in out/gaps; the same command goes on after a crash
  pneuflex sweep gaps.toml --workers 2 --threads 4
  pneuflex sweep gaps.toml --emit slurm > gaps.sh     jobs of a cluster, to be called by bash
  pneuflex sweep gaps.toml --only 17              what such a job does
  pneuflex sweep gaps.toml --join                 the table of what is finished

A file that solves six designs:
  case = \"finger.toml\"
  [space]
  \"actuator.gap\" = [1, 1.5, 2]
  \"actuator.side_wall\" = [0.8, 1]

Exit codes: 0 every design is finished, whatever became of it; 1 the table could not be written; 2 bad input (nothing written); 3 designs are left, which the same command tries again; 130 interrupted.";

/// Of `pneuflex view`.
pub const VIEW: &str = "\
Examples:
  pneuflex view out/actuator              out/actuator/report.html, to be opened in a browser";

/// Of `pneuflex picture`.
pub const PICTURE: &str = "\
Examples:
  pneuflex picture out/actuator
  pneuflex picture out/actuator --at 35 --colour displacement --view side --out bent.svg";

/// Of `pneuflex compare`.
pub const COMPARE: &str = "\
Examples:
  pneuflex compare out/actuator camera.csv                    pressure_kpa,x_mm,z_mm: points of the bottom line
  pneuflex compare out/actuator camera.csv --line outline --fit scale,rotation,offset
  pneuflex compare out/actuator angles.csv --out angles.png   pressure_kpa,end_face_angle_deg";

/// Of `pneuflex export`.
pub const EXPORT: &str = "\
Examples:
  pneuflex export out/actuator --to glb                       actuator.glb, which plays in a browser or on a slide
  pneuflex export out/actuator --to stl --at 35 --out bent.stl
  pneuflex export out/actuator --to gif --view side --width 500
  pneuflex export out/actuator --to npz                       numpy.load('actuator.npz')['displacement']
  pneuflex export out/actuator --to mould --wall 6            actuator-mould/half-left.stl, half-right.stl, core.stl";

/// Of `pneuflex find`.
pub const FIND: &str = "\
Examples:
  pneuflex find actuator.toml --angle 90                          the pressure for a bending angle of 90 degrees
  pneuflex find blocked_force.toml --force 0.1                    for a force of 0.1 N on the obstacle
  pneuflex find actuator.toml --tip-z -20 --by actuator.top_wall --between 0.8,2

Without --by it is looked for from rest to the last pressure or time of the case, and what is found is where the path first comes to it, as
far as the states at the case's pressures show. Nothing is written.

Exit codes: 0 found, 2 bad input, 3 never reached, 130 interrupted.";

/// Of `pneuflex design`.
pub const DESIGN: &str = "\
Examples:
  pneuflex design hook.toml
  pneuflex design hook.toml --resume                      goes on after Ctrl-C or a kill

A file that looks for two lengths, for an angle at the least mass:
  case = \"finger.toml\"
  [variables]
  \"actuator.top_wall\" = { from = 0.8, to = 2.5 }
  \"actuator.base\" = { from = 2.5, to = 4 }
  [[extreme]]
  least = \"silicone_volume\"
  [[limit]]
  result = \"end_face_angle\"
  at = 40
  at_least = 45

Exit codes: 0 targets met and limits held, 1 an output could not be written, 2 bad input (nothing written), 3 not met, or not converged, 130 interrupted.";

/// Of `pneuflex identify`.
pub const IDENTIFY: &str = "\
Examples:
  pneuflex identify bent.toml
  pneuflex identify bent.toml --resume                    goes on after Ctrl-C or a kill

A file that fits a constant and a wall to what was measured:
  case = \"finger.toml\"
  data = \"bent.csv\"                 # pressure_kpa,end_face_angle_deg,tip.z_mm and a row per pressure
  [variables]
  \"material.c10\" = { from = 0.1, to = 0.6 }
  \"actuator.top_wall\" = { from = 0.8, to = 1.6 }

Exit codes: 0 found, 1 an output could not be written, 2 bad input (nothing written), 3 the search ended before it came to an end, 130 interrupted.";

/// Of `pneuflex table`.
pub const TABLE: &str = "\
Examples:
  pneuflex table out/actuator
  pneuflex table out/thin out/thick --columns end_face_angle_deg
  pneuflex table out/actuator --as csv > actuator.csv";

/// Of `pneuflex rod`.
pub const ROD: &str = "\
Examples:
  pneuflex rod actuator.toml --set mesh.resolution=draft
  pneuflex rod actuator.toml --tip-load 0.05      with 0.05 N downwards on the tip";

/// Of `pneuflex completions`.
pub const COMPLETIONS: &str = "\
Examples:
  pneuflex completions bash > ~/.local/share/bash-completion/completions/pneuflex
  pneuflex completions zsh > \"${fpath[1]}/_pneuflex\"
  pneuflex completions fish > ~/.config/fish/completions/pneuflex.fish
  pneuflex completions powershell >> $PROFILE

They hold from the next shell on.";

/// Of `pneuflex man`.
pub const MAN: &str = "\
Examples:
  pneuflex man | man -l -
  pneuflex man ~/.local/share/man/man1            pneuflex.1, pneuflex-run.1 and so on";
