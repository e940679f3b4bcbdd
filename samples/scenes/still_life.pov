// A still life for the POV-Ray driver, made to be noisy: an open lens (focal blur), a jittered area light, blurred
// reflections by micro-normals, and a soft caustic-free glass.   povray +Istill_life.pov +W320 +H180
#version 3.7;
global_settings { assumed_gamma 1.0 max_trace_level 8 }
#default { finish { ambient 0 diffuse 0.8 } }

camera {
  location <0, 2.2, -7>
  right x * image_width / image_height
  up y
  angle 36
  look_at <0, 0.75, 0>
  aperture 0.3
  focal_point <-0.35, 0.8, -0.6>
  blur_samples 3
}

// One lamp, large: soft shadows. Few samples, at random places.
light_source {
  <5, 7, -4> color rgb 1.15
  area_light x * 3.5, z * 3.5, 2, 2
  jitter orient circular
}
sky_sphere { pigment { gradient y color_map { [0 rgb <0.42, 0.38, 0.34>] [1 rgb <0.10, 0.14, 0.22>] } } }

// Micro-normals: every ray meets another facet, which blurs what the surface mirrors.
#declare Brushed = normal { bumps 0.35 scale 0.0004 }

plane {
  y, 0
  texture {
    pigment { checker color rgb <0.62, 0.55, 0.46>, color rgb <0.20, 0.17, 0.15> scale 0.8 rotate y * 30 }
    normal { Brushed }
    finish { reflection { 0.04, 0.45 fresnel } conserve_energy }
  }
  interior { ior 1.5 }
}

plane { z, 6 inverse hollow texture { pigment { color rgb <0.50, 0.34, 0.28> } } }

// A brushed metal jug.
lathe {
  cubic_spline 8,
  <0.0, 0.0>, <0.42, 0.0>, <0.62, 0.45>, <0.50, 0.95>, <0.24, 1.35>, <0.26, 1.62>, <0.34, 1.75>, <0.36, 1.80>
  texture {
    pigment { color rgb <0.85, 0.62, 0.32> }
    normal { Brushed }
    finish { diffuse 0.25 reflection { rgb <0.60, 0.44, 0.23> } metallic }
  }
  translate <-1.35, 0, 0.5>
}

// Fruit: bumps that are large enough to see, and a soft highlight.
#declare Fruit = sphere { 0, 0.42 }
object {
  Fruit
  texture {
    pigment { bozo color_map { [0 rgb <0.85, 0.30, 0.05>] [1 rgb <0.95, 0.50, 0.10>] } scale 0.4 }
    normal { bumps 0.35 scale 0.03 }
    finish { phong 0.3 phong_size 30 }
  }
  translate <-0.35, 0.42, -0.6>
}
object {
  Fruit
  texture {
    pigment { gradient y color_map { [0 rgb <0.25, 0.42, 0.06>] [1 rgb <0.55, 0.62, 0.10>] } translate -0.5 }
    finish { phong 0.6 phong_size 60 reflection 0.06 }
  }
  translate <0.50, 0.42, -0.1>
}
object {
  Fruit
  texture { pigment { color rgb <0.45, 0.03, 0.05> } finish { phong 0.8 phong_size 80 reflection 0.08 } }
  translate <0.15, 0.42, 0.85>
}

// A glass ball, far right.
sphere {
  <1.75, 0.6, 0.2>, 0.6
  texture { pigment { color rgbf <0.93, 0.98, 0.96, 1> } finish { diffuse 0 reflection { 0.02, 1 fresnel } } }
  interior { ior 1.5 }
}

// Books behind, out of focus.
#declare Book = 0;
#declare Place = 0.2;
#declare Random = seed(7);
#while (Book < 7)
  #declare Thick = 0.16 + 0.14 * rand(Random);
  #declare Tall = 1.1 + 0.6 * rand(Random);
  box {
    <0, 0, 0>, <Thick, Tall, 0.9>
    texture {
      pigment { color rgb <0.15 + 0.6 * rand(Random), 0.12 + 0.3 * rand(Random), 0.10 + 0.4 * rand(Random)> }
      finish { specular 0.2 roughness 0.05 }
    }
    translate <Place, 0, 2.6>
  }
  #declare Place = Place + Thick + 0.02;
  #declare Book = Book + 1;
#end
