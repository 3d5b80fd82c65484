; THEOREM    01b: the way and the time of braking, for one piece of steady braking.
; ASSUMED    For the time t the robot brakes steadily at beta >= b and does not go backward.
; CONCLUDED  Its time and way are bounded as 01a assumes: b t <= v - v1, 2 b x <= v^2 - v1^2.
; SOURCE     own, kinematics.
; TWIN       the brakes are weaker than b instead of stronger.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const beta Real)     ; actual braking
(declare-const v Real)        ; speed of the robot
(declare-const v1 Real)       ; speed afterwards
(declare-const t Real)        ; time that passes
(declare-const x Real)        ; robot's own way meanwhile
; Assumptions
(assert (> b 0))
(assert (>= v 0))
(assert (>= v1 0))
(assert (>= t 0))
(assert (>= beta b))
(assert (= v1 (- v (* beta t))))
(assert (= x (- (* v t) (/ (* beta t t) 2))))

; Conclusion, negated
(assert (not (and (<= (* b t) (- v v1)) (<= (* 2 b x) (- (* v v) (* v1 v1))))))
(check-sat)
