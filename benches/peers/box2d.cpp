/* A step of Box2D, driven from C++. */
#include <box2d/box2d.h>

#include "drive.h"

int main(int count, char **words) {
    if (count != 3) return 2;
    b2World world(b2Vec2(0, 0));
    for (int row = 0; row < SIZE; row++)
        for (int col = 0; col < SIZE; col++)
            if (ROWS[row][col] == '#') {
                b2BodyDef wall;
                wall.position.Set(col + 0.5f, SIZE - row - 0.5f);
                b2PolygonShape box;
                box.SetAsBox(0.5f, 0.5f);
                world.CreateBody(&wall)->CreateFixture(&box, 0);
            }
    b2BodyDef disc;
    disc.type = b2_dynamicBody;
    disc.position.Set(START, START);
    b2Body *robot = world.CreateBody(&disc);
    b2CircleShape circle;
    circle.m_radius = RADIUS;
    b2FixtureDef fixture;
    fixture.shape = &circle;
    fixture.density = MASS / (PI * RADIUS * RADIUS);
    fixture.friction = 0.3f;
    robot->CreateFixture(&fixture);
    clock_t begin = clock();
    for (long step = 0; step < steps(words); step++) {
        double missing = wanted_speed(is_pushing(words), step) - robot->GetLinearVelocity().x;
        b2Vec2 impulse(limited(MASS * missing), 0);
        robot->ApplyLinearImpulse(impulse, robot->GetWorldCenter(), true);
        world.Step(DT, 4, 2);
    }
    report(begin, steps(words), robot->GetPosition().x);
}
