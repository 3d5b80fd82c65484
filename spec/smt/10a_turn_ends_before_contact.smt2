; THEOREM    10a: a turn ends before contact.
; ASSUMED    The turning guard holds; at t1 <= eps the turn, no faster than omega, begins to slow
;            down, at alpha or harder; the robot goes no farther than its way to rest (04c).
; CONCLUDED  Until the turn has ended the clearance is 0 at least.
; SOURCE     own; spec/shield.md SH.6.
; TWIN       the guard forgets how long the turn takes to slow down.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const s Real)        ; robot's own way since the thing was seen
(declare-const age Real)      ; time since the thing was seen
(declare-const d Real)        ; clearance when the thing was seen
(declare-const w Real)        ; greatest speed until the robot begins to brake
(declare-const x Real)        ; robot's own way meanwhile
(declare-const omega Real)    ; bound of the turn rate
(declare-const alpha Real)    ; turn acceleration
(declare-const omega1 Real)   ; turn rate when the turn is told to end
(declare-const t1 Real)       ; when that takes effect
(declare-const t2 Real)       ; time in which the turn slows down
; Formulas
(define-fun way_to_rest ((w Real)) Real (+ (* w eps) (/ (* w w) (* 2 b))))
(define-fun turn_time () Real (+ eps (/ omega alpha)))

; Assumptions
(assert (> b 0))
(assert (> eps 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= s 0))
(assert (>= age 0))
(assert (>= w 0))
(assert (>= x 0))
(assert (>= omega 0))
(assert (> alpha 0))
(assert (>= omega1 0))
(assert (>= t1 0))
(assert (>= t2 0))
(assert (<= (+ (* kappa (+ s (way_to_rest w))) (* V (+ age turn_time))) d))
(assert (<= t1 eps))
(assert (<= omega1 omega))
(assert (<= (* alpha t2) omega1))
(assert (<= x (way_to_rest w)))

; Conclusion, negated
(assert (not (>= (- d (* kappa (+ s x)) (* V (+ age t1 t2))) 0)))
(check-sat)
