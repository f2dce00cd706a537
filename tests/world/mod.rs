//! The world and the robot in it: files of worlds, maps, distances, arenas, and what is sensed.

mod bounds;
mod classic;
mod frames;
mod gridding;
mod maps;
mod metres;
mod nav2;
mod nav2_images;
mod physics;
mod sensing;
mod sensing_robots;
mod true_walls;
mod world_errors;
mod world_properties;
mod worlds;
