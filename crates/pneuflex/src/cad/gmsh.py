"""Meshes a part by Gmsh. Arguments: what to do, the part, the mesh to write, the size of elements in mm (0 for a coarse surface), straight or curved.

"surface" writes the triangles around every solid of a CAD file as STL, "volume" its solids filled with tetrahedra, and "fill" the inside of a surface of
triangles. What is said to the program goes to standard output, a word and a value on each line; the part is data, and nothing in it is run.
"""

import sys

try:
    import gmsh
except (ImportError, OSError) as missing:
    # The package, or a library of the system that it needs.
    print("missing", str(missing).replace("\n", " "))
    sys.exit(4)


def say(word, value):
    print(word, str(value).replace("\n", " "), flush=True)


def solids(part):
    """The solids of a CAD file by their names; faces in which they meet are one."""
    occ = gmsh.model.occ
    gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
    occ.importShapes(part, highestDimOnly=True)
    occ.synchronize()
    volumes = gmsh.model.getEntities(3)
    if not volumes:
        say("none", "solid")
        sys.exit(3)
    # "Shapes/ASSEMBLY/PART" and the like.
    names = [gmsh.model.getEntityName(*volume).rstrip("/").split("/")[-1].strip() for volume in volumes]
    # What its writer calls a solid without a name.
    names = ["" if name.startswith("Open CASCADE") else name for name in names]
    groups = {}
    if len(volumes) > 1:
        _, pieces = occ.fragment(volumes, [])
        occ.synchronize()
        taken = set()
        for number, (name, found) in enumerate(zip(names, pieces), 1):
            tags = [tag for dim, tag in found if dim == 3]
            if taken.intersection(tags):
                say("overlap", name or f"solid_{number}")
            taken.update(tags)
            groups[number] = (name, tags)
    else:
        groups[1] = (names[0], [volumes[0][1]])
    known = set()
    for number, (name, tags) in groups.items():
        unique = name if name and name not in known else f"{name or 'solid'}_{number}"
        known.add(unique)
        gmsh.model.addPhysicalGroup(3, tags, name=unique)
        say("solid", unique)


def inside(part, is_remeshed):
    """The inside of a closed surface of triangles: anew between its edges, or as it is."""
    gmsh.merge(part)
    if is_remeshed:
        gmsh.model.mesh.classifySurfaces(40 * 3.141592653589793 / 180, True, True, 3.141592653589793)
        gmsh.model.mesh.createGeometry()
    surfaces = [tag for _, tag in gmsh.model.getEntities(2)]
    loop = gmsh.model.geo.addSurfaceLoop(surfaces)
    volume = gmsh.model.geo.addVolume([loop])
    gmsh.model.geo.synchronize()
    gmsh.model.addPhysicalGroup(3, [volume], name="solid")
    say("solid", "solid")


def main(task, part, target, size, shape):
    gmsh.initialize(interruptible=False)
    option = gmsh.option.setNumber
    option("General.Terminal", 0)
    option("General.NumThreads", 1)
    option("Mesh.Binary", 1)
    option("Mesh.MshFileVersion", 4.1)
    if task == "fill":
        inside(part, shape != "as-it-is")
    else:
        solids(part)
    low_high = gmsh.model.getBoundingBox(-1, -1)
    diagonal = sum((low_high[d + 3] - low_high[d]) ** 2 for d in range(3)) ** 0.5
    size = float(size) or diagonal / 25
    option("Mesh.MeshSizeMax", size)
    option("Mesh.MeshSizeMin", size / 2)
    option("Mesh.MeshSizeFromCurvature", 8)
    if task == "surface":
        gmsh.model.mesh.generate(2)
        # A file for each solid: where two meet, both have the face.
        gmsh.model.removePhysicalGroups()
        for number, solid in enumerate(gmsh.model.getEntities(3), 1):
            faces = [abs(tag) for _, tag in gmsh.model.getBoundary([solid])]
            group = gmsh.model.addPhysicalGroup(2, faces)
            gmsh.write(f"{target}_{number}.stl")
            gmsh.model.removePhysicalGroups([(2, group)])
        return
    if shape == "as-it-is":
        option("Mesh.MeshSizeExtendFromBoundary", 1)
        option("Mesh.MeshOnlyEmpty", 1)
    option("Mesh.Optimize", 1)
    option("Mesh.OptimizeNetgen", 1)
    gmsh.model.mesh.generate(3)
    option("Mesh.SecondOrderLinear", 0 if shape == "curved" else 1)
    option("Mesh.HighOrderOptimize", 2 if shape == "curved" else 0)
    gmsh.model.mesh.setOrder(2)
    if shape == "curved":
        gmsh.model.mesh.optimize("HighOrder")
    gmsh.write(target)


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except Exception as error:
        say("error", error)
        sys.exit(3)
