#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "scene/scene_files.h"

namespace mrhi {
namespace {

// A tetrahedron with legs of 0.1 along the axes: volume 0.001 / 6.
const char* const kVertices = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\n";
const char* const kOutward = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const char* const kInward = "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
const double kVolume = 1e-3 / 6;

/// A scene of one free body whose collision shape is a mesh.
class MeshScene : public ::testing::Test {
 protected:
  std::string urdf(const std::string& attributes) {
    return folder_.write(
        "test.urdf", test::thing(std::string(test::kInertial) + "<collision><geometry><mesh " + attributes +
                                 "/></geometry></collision>"));
  }
  Mesh load(const std::string& attributes, const SceneOptions& options = {}) {
    scene_ = load_scene(urdf(attributes), options);
    return std::get<Mesh>(scene_.bodies.at(0).shapes.at(0).shape);
  }
  std::string error(const std::string& attributes) { return test::scene_error(urdf(attributes)); }
  /// Of that beginning.
  std::size_t warnings_of(const std::string& what) const {
    return std::size_t(std::count_if(scene_.warnings.begin(), scene_.warnings.end(),
                                     [&](const std::string& line) { return line.find(what) == 0; }));
  }

  test::Folder folder_;
  Scene scene_;
};

// 1e-6: vertices pass through floats.
TEST_F(MeshScene, IsClosedAndTurnedOutwardWhicheverWayTheFileIs) {
  for (const char* faces : {kOutward, kInward}) {
    folder_.write("wedge.obj", std::string(kVertices) + faces);
    const Mesh mesh = load("filename=\"wedge.obj\"");
    EXPECT_EQ(4u, mesh.triangles->vertices.size());
    EXPECT_EQ(4u, mesh.triangles->triangles.size());
    EXPECT_NEAR(kVolume, test::volume(*mesh.triangles), 1e-6 * kVolume);
  }
}

TEST_F(MeshScene, IsScaledAlsoByAMirror) {
  folder_.write("wedge.obj", std::string(kVertices) + kOutward);
  const Mesh mesh = load("filename=\"wedge.obj\" scale=\"2 -3 1\"");
  EXPECT_NEAR(6 * kVolume, test::volume(*mesh.triangles), 6e-6 * kVolume);
  EXPECT_EQ(Vector3(2, -3, 1), mesh.scale);
  EXPECT_NEAR(0.3, scene_.bodies.at(0).bounding_radius, 1e-6);
}

// A file of one group is read by ourselves; an empty second group leaves it to assimp.
TEST_F(MeshScene, OfAnObjIsTheSameWhoeverReadsIt) {
  std::string piece = "# piece\no piece\nvn 0 0 1\nvt 0 0\n";
  for (const char* vertex : {"0.0123456789 -1e-3 0", "  0.1 3.00000001E-2\t0.5e-1",
                             "-0.07 0.04 0.1234567891234", "+0.02 0.05 1.25e-2", "0.033333333 0.011 -0.1"})
    piece += std::string("v ") + vertex + "\r\n";
  for (const char* face : {"1 2/1 3/1/1", "1//1 3//1 4", "2 5 3", "1 5 2 ", "4 3 5", "1 4 5"})
    piece += std::string("f ") + face + "\n";
  std::string cube;
  for (int i = 0; i < 8; ++i)
    cube += std::string("v ") + (i & 1 ? "0.1 " : "0 ") + (i & 2 ? "0.1 " : "0 ") + (i & 4 ? "0.1\n" : "0\n");
  cube += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  folder_.write("ours.obj", cube);
  folder_.write("theirs.obj", cube + "g nothing\n");
  EXPECT_EQ(load("filename=\"ours.obj\"").triangles->triangles,
            load("filename=\"theirs.obj\"").triangles->triangles);
  for (const char* scale : {"", " scale=\"1 -2 3\""}) {
    folder_.write("ours.obj", piece);
    folder_.write("theirs.obj", piece + "g nothing\n");
    const Mesh ours = load(std::string("filename=\"ours.obj\"") + scale),
               theirs = load(std::string("filename=\"theirs.obj\"") + scale);
    ASSERT_EQ(ours.triangles->vertices.size(), theirs.triangles->vertices.size());
    for (std::size_t v = 0; v < 5; ++v)  // assimp rounds differently
      EXPECT_LT((ours.triangles->vertices[v] - theirs.triangles->vertices[v]).norm(), 1e-7);
    EXPECT_EQ(ours.triangles->triangles, theirs.triangles->triangles);
  }
}

TEST_F(MeshScene, IsReadFromAnAsciiStl) {
  const char* const facets[] = {"0 0 0 0 .1 0 .1 0 0", "0 0 0 .1 0 0 0 0 .1", "0 0 0 0 0 .1 0 .1 0",
                                ".1 0 0 0 .1 0 0 0 .1"};
  std::string stl = "solid wedge\n";
  for (const char* facet : facets) {
    std::istringstream numbers(facet);
    stl += "facet normal 0 0 0\nouter loop\n";
    for (std::string x, y, z; numbers >> x >> y >> z;) stl += "vertex " + x + " " + y + " " + z + "\n";
    stl += "endloop\nendfacet\n";
  }
  folder_.write("wedge.STL", stl + "endsolid wedge\n");
  const Mesh mesh = load("filename=\"wedge.STL\"");
  EXPECT_EQ(4u, mesh.triangles->vertices.size());
  EXPECT_NEAR(kVolume, test::volume(*mesh.triangles), 1e-6 * kVolume);
}

// The file says centimetres and y up: the first counts, the second does not.
TEST_F(MeshScene, IsReadFromADaeWithItsUnitButNotItsUpAxis) {
  folder_.write("wedge.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 10 0 0 0 20 0 0 0 30</float_array><technique_common>
<accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  const Mesh mesh = load("filename=\"wedge.dae\"");
  Vector3 furthest = Vector3::Zero();
  for (const Vector3& vertex : mesh.triangles->vertices) furthest = furthest.cwiseMax(vertex);
  EXPECT_TRUE(furthest.isApprox(Vector3(0.1, 0.2, 0.3), 1e-6)) << furthest.transpose();
}

TEST_F(MeshScene, IsFoundByPathFileUriAndPackage) {
  const std::string file = folder_.write("wedge.obj", std::string(kVertices) + kOutward);
  EXPECT_EQ("file://" + file, load("filename=\"wedge.obj\"").uri);
  EXPECT_EQ("file://" + file, load("filename=\"Wedge.OBJ\"").uri);
  EXPECT_EQ("file://" + file, load("filename=\"file://" + file + "\"").uri);
  folder_.write("my 50% wedge.obj", std::string(kVertices) + kOutward);
  for (const std::string name : {"my 50% wedge.obj", "my%2050%25%20wedge.obj", " my%2050%%20wedge.obj\n"})
    EXPECT_EQ("file://" + folder_.path() + "/my 50% wedge.obj", load("filename=\"" + name + "\"").uri);
  for (const std::string scheme : {"file://", "file://localhost"})
    EXPECT_EQ(4u, load("filename=\"" + scheme + folder_.path() + "/my%2050%25%20wedge.obj\"")
                      .triangles->vertices.size());
  SceneOptions options;
  options.resolve_package_uri = [&](const std::string& uri) {
    return uri == "package://shapes/wedge.obj" ? file : std::string();
  };
  EXPECT_EQ("package://shapes/wedge.obj", load("filename=\"package://shapes/wedge.obj\"", options).uri);
  test::expect_words(error("filename=\"package://shapes/wedge.obj\""),
                     {"package://shapes/wedge.obj", "package"});
}

TEST_F(MeshScene, RefusesAMissingOrBrokenFile) {
  test::expect_words(error("filename=\"none.stl\""),
                     {"'thing' collision 1", "'none.stl'", "not found", folder_.path()});
  {
    const test::WorkingFolder here(folder_.path());
    test::expect_words(test::scene_error("test.urdf"), {"'none.stl' not found in '" + folder_.path()});
  }
  folder_.write("broken.stl", "this is not a mesh");
  test::expect_words(error("filename=\"broken.stl\""), {"'thing' collision 1", "'broken.stl'", "read"});
  folder_.write("cut.stl", std::string(80, ' ') + std::string("\2\0\0\0", 4) + std::string(50, '\0'));
  test::expect_words(error("filename=\"cut.stl\""), {"'cut.stl'", "134 bytes", "184", "a whole STL"});
  folder_.write("empty.obj", "v 0 0 0\n");
  test::expect_words(error("filename=\"empty.obj\""), {"'empty.obj'"});
  folder_.write("wedge.blend", "blend");
  test::expect_words(error("filename=\"wedge.blend\""), {"'wedge.blend'", ".stl, .obj, .dae, .ply"});
  folder_.write("lfs.obj", "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n");
  test::expect_words(error("filename=\"lfs.obj\""), {"'lfs.obj'", "git lfs pull"});
  folder_.write("wedge.obj", std::string(kVertices) + kOutward);
  test::expect_words(error("filename=\"wedge.obj\" scale=\"1 0 1\""),
                     {"'thing' collision 1", "scale", "[1, 0, 1]"});
}

TEST_F(MeshScene, RefusesAVertexThatIsNoNumber) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float corners[4][3] = {{0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}, {0, 0, nan}};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  std::string stl(80, ' ');
  const std::uint32_t count = 4;
  const float normal[3] = {0, 0, 0};
  const auto append = [&](const void* data, std::size_t size) {
    stl.append(static_cast<const char*>(data), size);
  };
  append(&count, sizeof count);
  for (const auto& face : faces) {
    append(normal, sizeof normal);
    for (const int corner : face) append(corners[corner], sizeof corners[corner]);
    stl.append(2, '\0');
  }
  folder_.write("wedge.stl", stl);
  test::expect_words(error("filename=\"wedge.stl\""), {"'thing' collision 1", "'wedge.stl'", "not finite"});
}

TEST_F(MeshScene, IsHeldToTheSizesOfEveryOtherShape) {
  folder_.write("wedge.obj", std::string(kVertices) + kOutward);
  for (const char* scale : {"1e-8 1e-8 1e-8", "1 1 5e-5", "1e-31 1e-31 1e-31", "20000 20000 20000"})
    test::expect_words(error("filename=\"wedge.obj\" scale=\"" + std::string(scale) + "\""),
                       {"'thing' collision 1", "'wedge.obj'", "measures [", "from 1e-05 to 1000 m"});
  folder_.write("flat.obj", "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n");
  const auto seen = [&](const std::string& scale) {
    return load_scene(
        folder_.write("seen.urdf", test::thing(std::string(test::kInertial) + test::kBox +
                                               "<visual><geometry><mesh filename=\"flat.obj\" scale=\"" +
                                               scale + "\"/></geometry></visual>")),
        {});
  };
  EXPECT_TRUE(seen("1 1 1").warnings.empty()) << "a picture may be flat";
  const Scene small = seen("1e-8 1e-8 1e-8");
  test::expect_words(small.warnings.at(0), {"visual 1", "measures [", "along the longest axis"});
  EXPECT_TRUE(std::holds_alternative<Box>(small.bodies.at(0).visuals.at(0).shape))
      << "its collision is drawn";
}

TEST_F(MeshScene, TakesTheHullOfASurfaceThatIsNotClosedAndSaysSo) {
  folder_.write("open.obj", std::string(kVertices) + "f 1 3 2\nf 1 2 4\nf 1 4 3\n");
  EXPECT_NEAR(kVolume, test::volume(*load("filename=\"open.obj\"").triangles), 1e-6 * kVolume);
  test::expect_words(scene_.warnings.at(0), {"'open.obj'", "not closed", "are added"});
  folder_.write("pyramid.obj", std::string(kVertices) + "v 0.1 0.1 0\nf 1 2 4\nf 2 5 4\nf 5 3 4\nf 3 1 4\n");
  EXPECT_NEAR(2 * kVolume, test::volume(*load("filename=\"pyramid.obj\"").triangles), 2e-6 * kVolume);
  test::expect_words(scene_.warnings.at(0), {"'pyramid.obj'", "not closed", "convex hull"});
  folder_.write("leaf.obj", std::string(kVertices) + "f 1 2 3\nf 1 3 2\n");
  test::expect_words(error("filename=\"leaf.obj\""),
                     {"'thing'", "no collision with a volume", "flat sheets"});
}

TEST_F(MeshScene, IsReadFromAnStlWithBytesTooManyOrInCapitals) {
  folder_.write("wedge.ply",
                "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
                "z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n.1 0 0\n0 .1 "
                "0\n0 0 .1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  EXPECT_NEAR(kVolume, test::volume(*load("filename=\"wedge.ply\"").triangles), 1e-6 * kVolume);
  std::string binary(80, ' '), text = "SOLID WEDGE\n";
  const float corners[4][3] = {{0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}}, normal[3] = {0, 0, 0};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  binary.append("\4\0\0\0", 4);
  for (const auto& face : faces) {
    binary.append(reinterpret_cast<const char*>(normal), sizeof normal);
    text += "FACET NORMAL 0 0 0\nOUTER LOOP\n";
    for (const int v : face) {
      binary.append(reinterpret_cast<const char*>(corners[v]), sizeof corners[v]);
      text += "VERTEX";
      for (const float x : corners[v]) text += " " + std::to_string(x);
      text += "\n";
    }
    binary.append(2, '\0');
    text += "ENDLOOP\nENDFACET\n";
  }
  folder_.write("wedge.stl", binary + "more bytes");
  EXPECT_NEAR(kVolume, test::volume(*load("filename=\"wedge.stl\"").triangles), 1e-6 * kVolume);
  folder_.write("wedge.stl", "\n  " + text + "ENDSOLID WEDGE\n");
  EXPECT_NEAR(kVolume, test::volume(*load("filename=\"wedge.stl\"").triangles), 1e-6 * kVolume);
}

TEST_F(MeshScene, IsFoundInAFolderAboveThatIsThePackage) {
  const std::string inner = folder_.path() + "/cups/urdf";
  std::filesystem::create_directories(inner);
  folder_.write("cups/wedge.obj", std::string(kVertices) + kOutward);
  folder_.write("cups/urdf/cup.urdf",
                test::thing(std::string(test::kInertial) +
                            "<collision><geometry><mesh filename=\"package://cups/wedge.obj\"/>"
                            "</geometry></collision>"));
  const Scene scene = load_scene(inner + "/cup.urdf", {});
  ASSERT_EQ(1u, scene.mesh_files.size());
  EXPECT_EQ("package://cups/wedge.obj", scene.mesh_files[0].name);
  EXPECT_EQ(folder_.path() + "/cups/wedge.obj", scene.mesh_files[0].path);
  {
    const test::WorkingFolder here(inner);
    EXPECT_EQ("", test::scene_error("cup.urdf")) << "from its own folder";
  }
  std::filesystem::rename(folder_.path() + "/cups", folder_.path() + "/cups-main");
  const std::string unpacked = folder_.path() + "/cups-main/urdf/cup.urdf";
  test::expect_words(test::scene_error(unpacked), {"package://cups/wedge.obj", "not found", "ROS path"});
  folder_.write("cups-main/package.xml", "<package><name>cups</name></package>");
  EXPECT_EQ(1u, load_scene(unpacked, {}).mesh_files.size());
}

// One shape of two parts: one tree to search, and the same volume.
TEST_F(MeshScene, OfSeveralMeshesOfALinkIsOneShape) {
  folder_.write("wedge.obj", std::string(kVertices) + kOutward);
  const std::string mesh = "<geometry><mesh filename=\"wedge.obj\"/></geometry></collision>";
  const Scene scene = load_scene(
      folder_.write("two.urdf", test::thing(std::string(test::kInertial) + "<collision>" + mesh +
                                            "<collision><origin xyz=\"0.2 0 0\"/>" + mesh + test::kBox)),
      {});
  ASSERT_EQ(2u, scene.bodies.at(0).shapes.size());
  const Mesh& both = std::get<Mesh>(scene.bodies[0].shapes[1].shape);
  EXPECT_EQ((std::vector<int>{0, 4}), both.triangles->parts);
  EXPECT_NEAR(2 * kVolume, both.moments().volume, 2e-6 * kVolume);
  EXPECT_EQ(3u, scene.bodies[0].visuals.size());
}

// A heading over the next link is no order for the mesh before it.
TEST_F(MeshScene, IsTheHullOnlyIfTheCommentIsDirectlyBehindIt) {
  folder_.write("wedges.obj",
                std::string(kVertices) + kOutward +
                    "v 1 0 0\nv 1.1 0 0\nv 1 0.1 0\nv 1 0 0.1\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n");
  const std::string mesh = "<collision><geometry><mesh filename=\"wedges.obj\"/>";
  const auto volume_with = [&](const std::string& end) {
    const Scene scene = load_scene(
        folder_.write("h.urdf", test::robot(test::link("thing", test::kInertial + mesh + end) +
                                            test::joint("floating", "world", "thing") + "<!-- hull -->")),
        {});
    return test::volume(*std::get<Mesh>(scene.bodies.at(0).shapes.at(0).shape).triangles);
  };
  EXPECT_NEAR(2 * kVolume, volume_with("</geometry></collision><!-- hull -->"), 1e-5 * kVolume);
  for (const char* end : {"<!-- hull --></geometry></collision>", "</geometry><!--hull--></collision>"})
    EXPECT_GT(volume_with(end), 10 * kVolume) << end;
}

TEST_F(MeshScene, MayBeItsConvexHullAlsoIfItIsOpenOrHollow) {
  // A cube of 0.1 with a pit of half its height in the lid, and without its bottom.
  folder_.write(
      "pit.obj",
      "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nv 0 0 0.1\nv 0.1 0 0.1\nv 0.1 0.1 0.1\nv 0 0.1 0.1\n"
      "v 0.05 0.05 0.05\n"
      "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 9\nf 6 7 9\nf 7 8 9\nf 8 5 9\n");
  const auto with = [&](const std::string& comment) {
    return folder_.write("hull.urdf",
                         test::thing("<inertial><mass value=\"3\"/></inertial><collision><geometry>"
                                     "<mesh filename=\"pit.obj\"/>" +
                                     comment + "</geometry></collision>"));
  };
  const Scene scene = load_scene(with("<!-- hull -->"), {});
  scene_ = scene;
  EXPECT_EQ(0u, warnings_of("a mesh")) << "it was asked for";
  const Mesh hull = std::get<Mesh>(scene.bodies.at(0).shapes.at(0).shape);
  EXPECT_EQ(8u, hull.triangles->vertices.size());
  EXPECT_NEAR(1e-3, test::volume(*hull.triangles), 1e-9);
  EXPECT_EQ("file://" + folder_.path() + "/pit.obj", hull.uri);
  const Matrix3 inertia = scene.bodies.at(0).inertia;  // about a corner: its own, and m d^2
  EXPECT_NEAR(3.0 * 2.0 * 0.01 / 3.0, inertia(0, 0), 1e-7);
}

TEST_F(MeshScene, RefusesAHullOfNothing) {
  folder_.write("leaf.obj", std::string(kVertices) + "f 1 2 3\nf 1 3 2\n");
  const auto with = [&](const std::string& geometry) {
    return test::scene_error(
        folder_.write("hull.urdf", test::thing(std::string(test::kInertial) + "<collision><geometry>" +
                                               geometry + "</geometry></collision>")));
  };
  folder_.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n");
  test::expect_words(with("<mesh filename=\"flat.obj\"/><!-- hull -->"), {"'thing'", "flat"});
  test::expect_words(with("<!-- hull --><mesh filename=\"flat.obj\"/>"), {"hull", "behind no mesh"});
  test::expect_words(with("<box size=\"1 1 1\"/><!--hull-->"), {"hull", "behind no mesh"});
}

TEST_F(MeshScene, HasItsOwnInertiaIfOnlyItsMassIsGiven) {
  folder_.write("wedge.obj", std::string(kVertices) + kOutward);
  const Scene scene = load_scene(
      folder_.write("own.urdf", test::thing("<inertial><mass value=\"3\"/></inertial><collision><geometry>"
                                            "<mesh filename=\"wedge.obj\"/></geometry></collision>")),
      {});
  // Of a corner tetrahedron with legs a about that corner: the integral of x^2 is m a^2 / 10, of x y half
  // that.
  Matrix3 expected = Matrix3::Constant(-3.0 * 0.01 / 20.0);
  expected.diagonal().setConstant(2.0 * 3.0 * 0.01 / 10.0);
  EXPECT_LT((scene.bodies.at(0).inertia - expected).norm(), 1e-6 * expected.norm());
}

// Each facet's corners are off by some 1e-10 m, as a CAD program's are: 1e-9 of the size.
TEST_F(MeshScene, IsClosedOverASeamOfRounding) {
  folder_.write("seamed.obj",
                "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nv 0.1 1e-10 0\nv 1e-10 0.1 0\nv 0 0 0.1000000001\n"
                "v 0 -1e-10 0\nf 1 3 2\nf 8 5 4\nf 1 7 6\nf 2 3 4\n");
  const Mesh mesh = load("filename=\"seamed.obj\"");
  EXPECT_EQ(4u, mesh.triangles->triangles.size());
  EXPECT_NEAR(kVolume, test::volume(*mesh.triangles), 1e-6 * kVolume);
  // Beyond 1e-4 of the size a seam is a gap.
  folder_.write("gap.obj", std::string(kVertices) + "v 0.1 3e-5 0\nf 1 3 2\nf 1 5 4\nf 1 4 3\nf 2 3 4\n");
  load("filename=\"gap.obj\"");
  test::expect_words(scene_.warnings.at(0), {"'gap.obj'", "not closed"});
}

// As CAD programs write it where one face is meshed finer than the next: a vertex is on an edge of another.
TEST_F(MeshScene, IsClosedWhereAVertexIsOnTheEdgeOfAnotherTriangle) {
  folder_.write("wedge.obj", std::string(kVertices) +
                                 "v 0.05 0.05 0\nv 0.025 0.075 0\nf 1 3 2\nf 1 2 4\nf 1 4 3\n" +
                                 "f 2 5 4\nf 5 6 4\nf 6 3 4\n");
  EXPECT_NEAR(kVolume, test::volume(*load("filename=\"wedge.obj\"").triangles), 1e-6 * kVolume);
  EXPECT_EQ(0u, warnings_of("a mesh"));
}

// Two cubes of 0.1 beside each other. The faces that they share are divided along either diagonal.
TEST_F(MeshScene, OfSolidsThatShareAFaceIsOneSolid) {
  const std::string corners =
      "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nv 0 0 0.1\nv 0.1 0 0.1\nv 0.1 0.1 0.1\nv 0 0.1 0.1\n"
      "v 0.2 0 0\nv 0.2 0.1 0\nv 0.2 0 0.1\nv 0.2 0.1 0.1\n";
  const std::string left = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 4 1 5 8\n",
                    right = "f 2 3 10 9\nf 6 11 12 7\nf 2 9 11 6\nf 10 3 7 12\nf 9 10 12 11\n";
  for (const char* shared :
       {"f 2 3 7\nf 2 7 6\nf 2 7 3\nf 2 6 7\n", "f 2 3 7\nf 2 7 6\nf 2 6 3\nf 3 6 7\n"}) {
    folder_.write("cubes.obj", corners + left + right + shared);
    EXPECT_NEAR(2e-3, test::volume(*load("filename=\"cubes.obj\"").triangles), 1e-8) << shared;
    EXPECT_EQ(0u, warnings_of("a mesh"));
  }
}

// A pit in a cube, so that its hull is larger; each side of its lid is divided along another diagonal.
TEST_F(MeshScene, OfDoubledFacesIsOneOfEachPairHoweverTheSidesAreDivided) {
  const std::string corners =
      "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nv 0 0 0.1\nv 0.1 0 0.1\nv 0.1 0.1 0.1\nv 0 0.1 0.1\n"
      "v 0.05 0.05 0.05\n";
  const std::string walls =
                        "f 5 6 9\nf 6 7 9\nf 7 8 9\nf 8 5 9\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\n"
                        "f 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\nf 1 3 2\nf 1 4 3\n",
                    backs =
                        "f 5 9 6\nf 6 9 7\nf 7 9 8\nf 8 9 5\nf 1 5 2\nf 2 5 6\nf 2 6 3\nf 3 6 7\n"
                        "f 3 7 4\nf 4 7 8\nf 4 8 1\nf 1 8 5\nf 1 2 4\nf 2 3 4\n";
  folder_.write("pit.obj", corners + walls + backs);
  const double pit = 0.01 * 0.05 / 3.0;
  EXPECT_NEAR(1e-3 - pit, test::volume(*load("filename=\"pit.obj\"").triangles), 1e-8);
  EXPECT_EQ(0u, warnings_of("a mesh"));
}

TEST_F(MeshScene, IsAsLargeAsWhatIsLeftOfIt) {
  folder_.write("fin.obj", std::string(kVertices) + "v 0.9 0 0\nv 0.9 0.1 0\n" + kOutward + "f 2 5 6\n");
  const Mesh mesh = load("filename=\"fin.obj\"");
  EXPECT_EQ(4u, mesh.triangles->vertices.size());
  EXPECT_NEAR(0.1, scene_.bodies.at(0).bounding_radius, 1e-6);
  EXPECT_EQ(1u, warnings_of("a mesh has flat sheets"));
}

TEST_F(MeshScene, MayBeOpenWhereItIsOnlySeen) {
  folder_.write("open.obj", std::string(kVertices) + "f 1 3 2\n");
  const std::string visual = "<visual><geometry><mesh filename=\"open.obj\"/></geometry></visual>";
  const Scene scene = load_scene(
      folder_.write("seen.urdf", test::thing(std::string(test::kInertial) + test::kBox + visual)), {});
  EXPECT_EQ(1u, std::get<Mesh>(scene.bodies.at(0).visuals.at(0).shape).triangles->triangles.size());
}

}  // namespace
}  // namespace mrhi
