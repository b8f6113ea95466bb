"""The package as others build with it: outside of its tree, by its targets, and without ROS. With MR_HAND_CORE_BUILD=1
the core is built, tested and installed without ROS too, which takes minutes."""
import glob
import os
import re
import subprocess
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
REPOSITORY = os.path.dirname(os.path.dirname(HERE))
WITHOUT_ROS = ['-DCMAKE_DISABLE_FIND_PACKAGE_catkin=ON', '-DCMAKE_BUILD_TYPE=Release']


def run(*command, **options):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, **options)
    if done.returncode:
        raise AssertionError('%s\n%s' % (' '.join(command), done.stdout[-4000:]))
    return done.stdout


def prefixes():
    return os.pathsep.join([os.path.join(REPOSITORY, 'devel'), os.environ.get('CMAKE_PREFIX_PATH', '')]).strip(os.pathsep)


def build(consumer, prefix, folder):
    """The consumer's executable."""
    environment = dict(os.environ, CMAKE_PREFIX_PATH=prefix)
    run('cmake', '-S', os.path.join(REPOSITORY, 'test', 'consumers', consumer), '-B', folder,
        '-DPYTHON_EXECUTABLE=/usr/bin/python3', '-DPython3_EXECUTABLE=/usr/bin/python3', env=environment)
    run('cmake', '--build', folder, env=environment)
    return os.path.join(folder, consumer + '_consumer')


class Consumers(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def test_a_program_of_the_core(self):
        self.assertEqual(run(build('core', prefixes(), self.folder.name)), '0.100\n')

    def test_a_node_with_the_interaction_inside(self):
        run(build('ros', prefixes(), self.folder.name))

    def test_the_core_configures_without_ros(self):
        said = run('cmake', '-S', REPOSITORY, '-B', self.folder.name, *WITHOUT_ROS)
        self.assertIn('building without ROS', said)
        targets = run('cmake', '--build', self.folder.name, '--target', 'help')
        for target in 'mr_hand_interaction_core', 'replay', 'test_laws':
            self.assertIn(target, targets)
        self.assertNotIn('interaction_node', targets)

    def test_names_from_before_the_first_release_compile_and_are_deprecated(self):
        headers = []
        for path in glob.glob(os.path.join(REPOSITORY, 'include', '**', '*.h'), recursive=True):
            with open(path, encoding='utf-8') as file:
                if '// Deprecated' in file.read():
                    headers.append(os.path.relpath(path, os.path.join(REPOSITORY, 'include')))
        self.assertEqual(len(headers), 11)
        types = ('HandPairs', 'JointGaps', 'SessionSetup', 'SessionFolder', 'Material', 'UsageError', 'JointState', 'HandOffset',
                 'TrackingNoise', 'FilterMemory')
        code = ''.join('#include "%s"\n' % header for header in sorted(headers))
        code += '#include "mr_hand_interaction/response/grip.h"\nnamespace mrhi {\n'
        code += ''.join('using Old%s = %s;\n' % (name, name) for name in types)
        code += ('double aperture_of(const Grip& grip, const Hand& hand) { return opening(grip, hand); }\n'
                 'auto leaves(const Box& box) { return box.way_out(Vector3::Zero(), Vector3::UnitX()); }\n}\n')
        eigen = run('pkg-config', '--cflags', 'eigen3').split()
        said = run('g++', '-std=c++17', '-fsyntax-only', '-I' + os.path.join(REPOSITORY, 'include'), *eigen, '-x', 'c++', '-',
                   input=code)
        self.assertIn('use aperture', said)
        self.assertIn('use exit_distance', said)

    def test_a_new_source_file_compiles_alone_beside_precompiled_headers(self):
        def write(name, text):
            with open(os.path.join(self.folder.name, name), 'w') as file:
                file.write(text)

        def compiled():
            run('cmake', '-S', self.folder.name, '-B', tree)
            return sorted(re.findall(r'(\w+)\.cpp\.o$', run('cmake', '--build', tree), re.MULTILINE))
        tree = os.path.join(self.folder.name, 'build')
        write('CMakeLists.txt', 'cmake_minimum_required(VERSION 3.10)\nproject(toy CXX)\nset(CMAKE_CXX_STANDARD 17)\n'
              'find_package(Eigen3 REQUIRED NO_MODULE)\ninclude(%s/cmake/precompiled.cmake)\nfile(GLOB sources *.cpp)\n'
              'add_library(toy STATIC ${sources})\ntarget_link_libraries(toy Eigen3::Eigen)\nprecompile(toy)\n' % REPOSITORY)
        for name in ('first', 'second'):
            write(name + '.cpp', 'int %s() { return static_cast<int>(std::string("x").size()); }\n' % name)
        self.assertEqual([name for name in compiled() if 'pre' not in name], ['first', 'second'])
        write('third.cpp', 'int third() { return 3; }\n')
        self.assertEqual(compiled(), ['third'])

    @unittest.skipUnless(os.environ.get('MR_HAND_CORE_BUILD'), 'takes minutes: set MR_HAND_CORE_BUILD=1')
    def test_the_core_builds_runs_and_installs_without_ros(self):
        tree, prefix = os.path.join(self.folder.name, 'build'), os.path.join(self.folder.name, 'prefix')
        run('cmake', '-S', REPOSITORY, '-B', tree, '-DCMAKE_INSTALL_PREFIX=' + prefix, '-DWARNINGS_AS_ERRORS=ON',
            *WITHOUT_ROS)
        run('cmake', '--build', tree, '--', '-j2')
        run('ctest', '--output-on-failure', '-R', 'scene|replay|collision', cwd=tree)
        run('cmake', '--build', tree, '--target', 'install')
        self.assertEqual(run(build('core', prefix, os.path.join(self.folder.name, 'consumer'))), '0.100\n')
        self.assertIn('usage', run(os.path.join(prefix, 'lib', 'mr_hand_interaction', 'replay'), '--help'))


if __name__ == '__main__':
    unittest.main()
