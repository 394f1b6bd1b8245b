#!/usr/bin/env python3
"""Builds the Debian packages, unpacks them, and uses them. Usage: packages_test.py BUILD_FOLDER"""
import gzip
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

CONSUMER = pathlib.Path(__file__).parent / "consumer"
BUILD = None  # from the command line


def call(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


class PackagesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        for tool in ("dpkg-deb", "dpkg-shlibdeps", "cpack"):
            if not shutil.which(tool):
                raise unittest.SkipTest(f"no {tool}")
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        folder = pathlib.Path(cls.temporary.name)
        call("cmake", "--build", BUILD, "--target", "manual")
        call("cpack", "-G", "DEB", "--config", BUILD / "CPackConfig.cmake", "-B", folder, umask=0o022)
        cls.packages = {path.name.split("_")[0]: path for path in folder.glob("*.deb")}
        cls.root = folder / "root"
        for package in cls.packages.values():
            call("dpkg-deb", "-x", package, cls.root)

    def field(self, package, name):
        return call("dpkg-deb", "-f", self.packages[package], name).strip()

    def files(self, package):
        """Path -> mode and owner."""
        lines = call("dpkg-deb", "-c", self.packages[package]).splitlines()
        return {words[5]: (words[0], words[1]) for words in (line.split(None, 5) for line in lines)}

    def hub(self):
        process = subprocess.Popen([self.root / "usr/bin/vismap-hub", "--listen", "127.0.0.1:0"],
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        return process.stdout.readline().strip()

    def test_there_are_four(self):
        self.assertEqual(set(self.packages), {"vismap", "libvismap-client0", "vismap-dev", "python3-vismap"})

    def test_control_fields(self):
        depends = self.field("vismap", "Depends")
        for library in ("liblcm1", "libtbb12", "libsystemd0", "libstdc++6"):
            self.assertIn(library, depends)
        self.assertNotIn("-dev", depends)
        self.assertEqual(self.field("vismap", "Architecture"), call("dpkg", "--print-architecture").strip())
        for library in ("libvismap-client0", "liblcm-dev"):
            self.assertIn(library, self.field("vismap-dev", "Depends"))
        self.assertIn("liblcm1", self.field("libvismap-client0", "Depends"))
        self.assertEqual(self.field("python3-vismap", "Architecture"), "all")
        self.assertIn("python3-numpy", self.field("python3-vismap", "Depends"))
        for package in self.packages:
            self.assertRegex(self.field(package, "Version"), r"^\d+\.\d+\.\d+$")
            self.assertIn("@", self.field(package, "Maintainer"))
            summary, *long = self.field(package, "Description").splitlines()
            self.assertLess(len(summary), 80)
            self.assertTrue(long and all(line.startswith(" ") for line in long), long)

    def test_files_are_roots_in_known_places_with_plain_modes(self):
        for package in self.packages:
            names = self.files(package)
            self.assertIn(f"./usr/share/doc/{package}/copyright", names)
            self.assertIn(f"./usr/share/doc/{package}/changelog.gz", names)
            for name, (mode, owner) in names.items():
                self.assertEqual(owner, "root/root", name)
                self.assertRegex(mode, r"^(drwxr-xr-x|-rw-r--r--|-rwxr-xr-x|lrwxrwxrwx)$", name)
                self.assertRegex(name, r"^\./($|etc/($|vismap/)|usr/($|bin/|include/|share/|"
                                 r"lib/($|systemd/|python3/|[a-z0-9_]+-linux-gnu/($|cmake/|pkgconfig/|libvismap-client\.so))))", name)

    def test_settings_are_conffiles(self):
        control = pathlib.Path(self.temporary.name) / "control"
        call("dpkg-deb", "-e", self.packages["vismap"], control)
        listed = set((control / "conffiles").read_text().split())
        packed = {name[1:] for name in self.files("vismap") if name.startswith("./etc/") and not name.endswith("/")}
        self.assertEqual(listed, packed)
        self.assertIn("/etc/vismap/map-server.txtpb", listed)
        for script in ("postinst", "prerm"):
            self.assertTrue(os.access(control / script, os.X_OK), script)
            call("sh", "-n", control / script)

    def test_programs_run_where_they_are_unpacked(self):
        programs = [path for path in (self.root / "usr/bin").iterdir() if not path.is_symlink()]
        self.assertGreaterEqual(len(programs), 8)
        for program in programs:
            self.assertIn(program.name, call(program, "--version"))
            self.assertNotIn("not found", call("ldd", program))
            self.assertNotIn("RUNPATH", call("readelf", "-d", program), "libraries come from the system")
            self.assertFalse(re.search(r"\.debug_info", call("readelf", "-S", program)), "stripped")
        for tool in ("launch", "deploy-check"):
            call(self.root / f"usr/bin/vismap-{tool}", "--help", env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"})
        call(self.root / "usr/bin/vismap-launch", self.root / "usr/share/vismap/launch/room.pmd", "--check", "--bin",
             self.root / "usr/bin")

    def commands(self):
        return sorted(path.name for path in (self.root / "usr/bin").iterdir())

    def test_every_command_has_a_manual_page(self):
        for command in self.commands():
            with gzip.open(self.root / f"usr/share/man/man1/{command}.1.gz", "rt") as file:
                page = file.read()
            self.assertRegex(page, rf"\.SH NAME\n{command} \\- [a-z]", command)
            self.assertIn("\\-\\-help", page, command)
            shown = call("man", "--warnings", "-l", self.root / f"usr/share/man/man1/{command}.1.gz",
                         env={**os.environ, "MANPAGER": "cat", "LC_ALL": "C.UTF-8"}) if shutil.which("man") else ""
            self.assertTrue(not shown or "--help" in shown, command)
        with gzip.open(self.root / "usr/share/man/man1/vismap-map.1.gz", "rt") as file:
            self.assertIn("--object", file.read().replace("\\-", "-"), "the options of its subcommands")

    def complete(self, *words):
        """What bash offers after these words, of which the last one is being typed."""
        script = self.root / f"usr/share/bash-completion/completions/{words[0]}"
        line = (f". {script}; COMP_WORDS=({' '.join(repr(word) for word in words)}); COMP_CWORD={len(words) - 1}; "
                "_vismap; printf '%s\\n' \"${COMPREPLY[@]}\"")
        path = f"{self.root}/usr/bin:{os.environ['PATH']}"
        return call("bash", "-c", line, env={**os.environ, "PATH": path}).split()

    def test_bash_completes_options_verbs_and_choices(self):
        for command in self.commands():
            self.assertIn("--help", self.complete(command, "--h"), command)
        self.assertEqual(self.complete("vismap-map", "ren"), ["render"])
        self.assertEqual(self.complete("vismap-map", "export", "--obj"), ["--object"])
        self.assertEqual(self.complete("vismap-hub", "--log-level", "w"), ["warning"])
        self.assertEqual(self.complete("vismap-hub", "--nothing-like-this"), [])

    @unittest.skipUnless(shutil.which("lintian"), "no lintian")
    def test_lintian_has_nothing_to_say(self):
        said = call("lintian", "--allow-root", *self.packages.values(), timeout=240)
        self.assertEqual(said.strip(), "")

    def test_links_between_documents_work(self):
        folder = self.root / "usr/share/doc/vismap"
        documents = list(folder.rglob("*.md"))
        self.assertGreaterEqual(len(documents), 6)
        for document in documents:
            for target in re.findall(r"\]\(([^):#]+)(?:#[^)]*)?\)", document.read_text()):
                self.assertTrue((document.parent / target).is_file(), f"{document.relative_to(folder)}: {target}")

    def test_units_name_programs_of_the_package(self):
        unit = (self.root / "usr/lib/systemd/system/vismap@.service").read_text()
        self.assertIn("ExecStart=/usr/bin/vismap-%i ", unit)
        for environment in (self.root / "etc/vismap").glob("*.env"):
            if environment.name != "vismap.env":
                self.assertTrue((self.root / f"usr/bin/vismap-{environment.stem}").exists(), environment.name)

    def test_python_package(self):
        installed = self.root / "usr/lib/python3/dist-packages"
        program = ("import vismap, vismap.map_file, sys\n"
                   "vismap.map_file._schema()\n"
                   "with vismap.Bus(sys.argv[1]) as bus:\n"
                   "    print(vismap.__version__, len(vismap.types), bus.subscribe('STATUS').get(20).decode().process)\n")
        printed = call("/usr/bin/python3", "-B", "-c", program, self.hub(), env={**os.environ, "PYTHONPATH": str(installed)}, cwd=self.root,
                       timeout=60)
        version, types, process = printed.split()
        self.assertEqual((version, process), (self.field("python3-vismap", "Version"), "hub"))
        texts = CONSUMER.parents[2] / "lcmtypes"
        self.assertEqual(int(types), len([*texts.glob("*.lcm"), *texts.glob("older/*.lcm")]))
        example = self.root / "usr/share/doc/python3-vismap/examples/camera_driver.py"
        self.assertIn("--rate", call("/usr/bin/python3", example, "--help", env={**os.environ, "PYTHONPATH": str(installed), "PYTHONDONTWRITEBYTECODE": "1"}))
        control = pathlib.Path(self.temporary.name) / "python-control"
        call("dpkg-deb", "-e", self.packages["python3-vismap"], control)
        for script in ("postinst", "prerm"):
            call("sh", "-n", control / script)

    def test_another_program_by_pkg_config(self):
        environment = {**os.environ, "PKG_CONFIG_PATH": str(next(self.root.glob("usr/lib/*/pkgconfig"))),
                       "PKG_CONFIG_SYSROOT_DIR": str(self.root)}
        flags = call("pkg-config", "--cflags", "--libs", "vismap", env=environment).split()
        program = pathlib.Path(self.temporary.name) / "by-pkg-config"
        call("c++", "-std=c++17", CONSUMER / "consumer.cc", *flags, "-o", program)
        self.assertRegex(call(program, self.hub(), timeout=60), r"^hub \d")

    def test_a_planner_by_pkg_config(self):
        environment = {**os.environ, "PKG_CONFIG_PATH": str(next(self.root.glob("usr/lib/*/pkgconfig"))),
                       "PKG_CONFIG_SYSROOT_DIR": str(self.root)}
        flags = call("pkg-config", "--cflags", "--libs", "vismap-client", env=environment).split()
        program = pathlib.Path(self.temporary.name) / "planner"
        call("c++", "-std=c++17", CONSUMER / "planner.cc", *flags, "-o", program)
        libraries = next(self.root.glob("usr/lib/*/libvismap-client.so.0")).parent
        said = call(program, self.hub(), timeout=60, env={**os.environ, "LD_LIBRARY_PATH": str(libraries)})
        self.assertIn("nothing was heard of the octomap exporter yet", said)

    def test_another_program_by_cmake(self):
        build = pathlib.Path(self.temporary.name) / "by-cmake"
        call("cmake", "-S", CONSUMER, "-B", build, f"-DCMAKE_PREFIX_PATH={self.root}/usr")
        call("cmake", "--build", build)
        self.assertRegex(call(build / "consumer", self.hub(), timeout=60), r"^hub \d")
        flags = (build / "CMakeFiles/consumer.dir/flags.make").read_text()
        self.assertIn(f"{self.root}/usr/include", flags)
        self.assertNotIn(str(BUILD), flags)

    def test_the_camera_driver_publishes_frames_that_a_segmenter_takes(self):
        build = pathlib.Path(self.temporary.name) / "examples"
        call("cmake", "-S", self.root / "usr/share/doc/vismap-dev/examples", "-B", build,
             f"-DCMAKE_PREFIX_PATH={self.root}/usr")
        call("cmake", "--build", build, "--target", "camera_driver", "plan_grid")  # plan_sphere takes a minute
        url = self.hub()
        segmenter = subprocess.Popen([self.root / "usr/bin/vismap-depth-segmenter", "--lcm-url", url, "--detections",
                                      "none"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.addCleanup(segmenter.stderr.close)
        self.addCleanup(segmenter.wait)
        self.addCleanup(segmenter.terminate)
        said = call(build / "camera_driver", "--lcm-url", url, "--frames", "30", timeout=60)
        self.assertRegex(said, r"^published 30 frames, skipped \d+, unsent 0$")
        segmenter.terminate()
        summary = segmenter.stderr.read()
        segmented = re.search(r"segmented (\d+) frames", summary)
        self.assertTrue(segmented and int(segmented[1]) >= 20, summary)


if __name__ == "__main__":
    BUILD = pathlib.Path(sys.argv.pop()).resolve()
    unittest.main()
